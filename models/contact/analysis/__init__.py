"""Film solutions for analyses: infinite and finite line contacts. No component uses them."""
