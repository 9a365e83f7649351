"""FMUs of the components: build, check, reference results."""
