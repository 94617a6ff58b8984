"""The popular benchmark problems of Sze, Liu, Lo, Finite Elem. Anal. Des. 40 (2004) 1551-1569. One file a problem."""
