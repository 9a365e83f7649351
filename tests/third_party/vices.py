"""What an FMU may do that ends, hinders or deceives its run: C of a step, by name."""

VICES = {
    "crashing": "raise(SIGSEGV);",
    "leaving": "_exit(7);",
    "slipping away": "_exit(0);",
    "closing": "for (int i = 0; i < 999; i++) close(i);",
    "scribbling": 'for (int i = 3; i < 999; i++) { ssize_t n = write(i, "nonsense nonsense", 17); (void)n; }',
    "feigning": '{ char head[17] = "tribocosd"; memset(head + 9, 7, 8); '
    "for (int i = 3; i < 999; i++) { ssize_t n = write(i, head, 17); (void)n; } }",
    "forking": "fork();",
    "doubling": "{ static int made; if (!made++) fork(); }",
    # Its child, in a session of its own, whose number is in the file MARK.
    "detaching": """{ static int made; int child = made++ ? -1 : fork();
        if (!child) {
            setsid();
            if (!(child = fork())) for (;;) pause();
            FILE *f = fopen(getenv("MARK"), "w"); fprintf(f, "%d", child); fclose(f); _exit(0);
        }
        if (child > 0) waitpid(child, 0, 0); }""",
    "killing": "{ kill(getppid(), SIGKILL); for (;;) pause(); }",
    "spinning": "for (;;) ;",
    "deaf": """{ signal(SIGTERM, SIG_IGN); fclose(fopen(getenv("MARK"), "w")); for (;;) ; }""",
    "spinning once": 'if (getenv("MARK")) { fclose(fopen(getenv("MARK"), "w")); for (;;) ; }',
    "quitting": "exit(0);",
    "aborting": "abort();",
    "hanging": "for (;;) pause();",
    "discarding": '{ say(m, DISCARD, "no way on"); return DISCARD; }',
    "erring": '{ say(m, ERROR, "out of range"); return ERROR; }',
    "fatal": '{ say(m, FATAL, "memory is gone"); return FATAL; }',
    "ending": '{ m->reached = 0.5; say(m, OK, "has landed"); return ENDED; }',
}
