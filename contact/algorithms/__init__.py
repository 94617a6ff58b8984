"""Contact algorithms, one file each: parameters, ``supports``, ``solve``. No algorithm imports another's file."""
