"""``python -m server.cli`` is ``slamdeck``."""

from server.cli import main

if __name__ == "__main__":
    main()
