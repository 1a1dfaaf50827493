"""Every reader of a data file with a small valid file for it: the table that tests and fuzzing go through.

`READERS[name].place(folder)` writes a valid input under an empty folder and gives the file in it that is to
be damaged; `READERS[name].read(file)` reads it, with what lies beside it. A reader may return or raise
InputError, in bounded time and memory, whatever that file holds; anything else is a mistake of the program.
"""

from tests.fuzz.image_readers import IMAGE_READERS
from tests.fuzz.reader import Reader
from tests.fuzz.result_readers import RESULT_READERS
from tests.fuzz.road_readers import ROAD_READERS

READERS: dict[str, Reader] = ROAD_READERS | IMAGE_READERS | RESULT_READERS
