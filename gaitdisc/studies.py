"""The studies by one name: `from gaitdisc.studies.chapter3.recommend import recommend`.

In a checkout they lie beside the package, in a wheel within it.
"""

from gaitdisc.run.chapter_parts import studies_folder

__path__ = [str(studies_folder())]
