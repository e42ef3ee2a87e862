"""Arguments of several renders in one command line."""


def jobs(arguments):
    """Yields the arguments of each render, as lists; "+" stands between them."""
    job = []
    for argument in arguments:
        if argument == "+":
            yield job
            job = []
        else:
            job.append(argument)
    yield job
