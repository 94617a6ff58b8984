"""Pages of shells without contact: benchmarks, convergence, measures, rigid motions, locking."""
