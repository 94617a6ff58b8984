"""All pages as ONE file of HTML that needs nothing else: style, script and pictures are in it, no network is.

Without a script the pages stand below one another; with it, one at a time, with a search over all of them, tables that
sort and filter, and a dark scheme.
"""
