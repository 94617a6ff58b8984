"""Benchmarks of cost, as ratios inside one run, and the lane of repeated timings. No verdict about accuracy."""
