"""How the scripts of this folder end."""


def verdict(problems, named):
    """Prints each problem and then their number, of what is `named`. Returns the exit code."""
    found = list(problems)
    for line in found:
        print(line)
    print(f"{len(found)} {named}")
    return 1 if found else 0
