"""The cells of a campaign as records and tables: what was asked, what was answered, where, and what is given away.

An error may not be verified here, and no cell ranked: that is made of these tables, beside this folder.
"""
