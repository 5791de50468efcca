"""``python -m hfanalysis`` is ``hfa``."""

from hfanalysis.cli import main

if __name__ == "__main__":
    main()
