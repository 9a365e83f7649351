"""report.html: its size, the processor time to write it, and that of a zoom in a browser.

A zoom draws four plots and a phase plot. Its time is that of the page's thread, until the third picture.
"""

import shutil
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

from orchestrator.report import write_report
from tests.report.large import write_large

CASES = ((24_000, 53), (1_000_000, 4), (1_000_000, 40))
SPANS = (10.0, 5.0, 2.0, 1.0, 0.5, 0.3, 0.2, 0.1, 0.03, 0.01, 0.003)
ZOOM = """async (span) => {
  const picture = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 0)));
  report.view.shown = [0.3 * (10 - span), 0.3 * (10 - span) + span]; report.view.tell();
  for (let k = 0; k < 3; k++) await picture();
}"""


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    found = []
    for rows, variables in CASES:
        with tempfile.TemporaryDirectory() as folder:
            write_large(Path(folder), rows, variables)
            began = time.process_time()
            path = write_report(Path(folder))
            seconds = time.process_time() - began
            name = f"report: {rows} rows, {variables} variables"
            found.append((name, f"{1e-6 * path.stat().st_size:.1f} MB, written in {seconds:.2f} s"))
            if chromium := shutil.which("chromium"):
                times = measure_zooms(path, chromium)
                median, most = statistics.median(times), max(times)
                found.append((f"{name}: a zoom", f"{median:.0f} ms, at most {most:.0f} ms"))
    return found


def measure_zooms(path: Path, chromium: str) -> list[float]:
    """Processor time (ms) of the page for each zoom, once everything is unpacked."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 1240, "height": 1000})
        page.goto(path.as_uri())
        page.wait_for_selector("body[data-ready]")
        page.wait_for_timeout(2000)
        session = page.context.new_cdp_session(page)
        session.send("Performance.setTimeDomain", {"timeDomain": "threadTicks"})
        session.send("Performance.enable")
        times = []
        for span in SPANS:
            before = _read_clock(session)
            page.evaluate(ZOOM, span)
            times.append(1e3 * (_read_clock(session) - before))
        browser.close()
    return times


def _read_clock(session: Any) -> float:
    """Processor time of the page's tasks (s)."""
    metrics = session.send("Performance.getMetrics")["metrics"]
    return next(float(one["value"]) for one in metrics if one["name"] == "TaskDuration")
