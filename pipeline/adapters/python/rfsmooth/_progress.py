"""Where the progress of a call goes."""

import contextlib


@contextlib.contextmanager
def listener(progress):
    """A callable of (stage, share done) for None, True (a bar of tqdm, if that is installed) or a callable."""
    if progress is None or progress is False:
        yield None
    elif progress is True:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            yield None
            return
        with tqdm(total=100, unit="%", bar_format="{desc:<12.12} {bar} {n:3.0f} % [{elapsed}<{remaining}]") as bar:

            def draw(stage, share):
                bar.set_description_str(stage, refresh=False)
                bar.update(100 * share - bar.n)

            yield draw
    else:
        yield progress
