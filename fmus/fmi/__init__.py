"""Reading and writing of the FMI file format."""
