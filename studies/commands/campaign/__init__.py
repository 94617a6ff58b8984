"""Commands on the cells of a store: solve, list, time, analyse, report and advise from a campaign."""
