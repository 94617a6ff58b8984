"""The collection of frozen contact problems: where they come from, by which rule they are chosen, how they go out.

No solver is compared and no answer from outside is read here.
"""
