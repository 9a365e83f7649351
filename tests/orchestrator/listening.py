"""Where processes of a group listen on this machine, and what they answer a stranger."""

import asyncio
import contextlib
import http.client
import os
from pathlib import Path
from typing import Any

from distributed import Security
from distributed.comm import connect


def list_processes(group: int) -> list[int]:
    """The processes that still run in a group."""
    found = []
    for entry in Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            status = (entry / "stat").read_text().rpartition(")")[2].split()
            if int(status[2]) == group and status[0] != "Z":
                found.append(int(entry.name))
    return found


def list_ports(group: int) -> set[int]:
    """The ports of this machine at which processes of the group listen."""
    sockets = set()
    for process in list_processes(group):
        with contextlib.suppress(OSError):
            sockets |= {os.readlink(file) for file in Path(f"/proc/{process}/fd").iterdir()}
    ports = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            _, local, _, state, *_, inode = line.split()[:10]
            if state == "0A" and f"socket:[{inode}]" in sockets:
                ports.add(int(local.rpartition(":")[2], 16))
    return ports


def request_pages(ports: set[int]) -> dict[int, int]:
    """The status of a page of dask's at each of the ports that answer as a web server."""
    found = {}
    for port in ports:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=3.0)
        with contextlib.suppress(OSError, http.client.HTTPException), contextlib.closing(connection):
            connection.request("GET", "/health")
            found[port] = connection.getresponse().status
    return found


async def list_answers(ports: set[int]) -> list[str]:
    """Where dask answers one who has no certificate, or one of his own."""
    own = Security.temporary().get_connection_args("client")
    places = [(f"{kind}://127.0.0.1:{port}", options) for port in ports
              for kind, options in (("tcp", {}), ("tls", own))]  # fmt: skip

    async def answers(place: str, options: dict[str, Any]) -> bool:
        try:
            comm = await connect(place, timeout=3.0, **options)
        except (OSError, ValueError):  # the latter for TLS where none is spoken
            return False
        comm.abort()
        return True

    found = await asyncio.gather(*(answers(*place) for place in places))
    return [place for (place, _), yes in zip(places, found, strict=True) if yes]
