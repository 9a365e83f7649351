"""Film solutions for analyses: line contacts. No component uses them."""
