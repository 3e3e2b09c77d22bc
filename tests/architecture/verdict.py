"""The last output and the exit code of the scripts in this folder."""


def verdict(problems, named):
    """Prints each problem, and their number with the noun `named`. Returns the exit code."""
    found = list(problems)
    for line in found:
        print(line)
    print(f"{len(found)} {named}")
    return 1 if found else 0
