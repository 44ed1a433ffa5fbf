"""Numba's cache of compiled code on the disk, made to bear what disks go through.

* A compiled function is made anew when any file changes that it was made of (`source_stamp`); Numba looks at its own file alone.
* What cannot be read, after a full disk or a power cut, is compiled anew and replaced; so is what has other bytes than were
  written, or was written for another function or another text. Object code that is no such thing would end the process.
* Where nothing can be written, what is there is read, and the rest is compiled in each process.

A line in the log of `integrators` tells of the last two, once in a process.
"""

import hashlib
import logging
import os
import pickle
from contextlib import suppress

from numba.core import config
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator
from numba.core.serialize import dumps

from .linked_code import LINKED, loaded
from .source_stamp import source_stamp

LOG = logging.getLogger(__name__)


class _Unwritable(_CacheLocator):
    """Where compiled code is read from if no folder can be written."""

    def __init__(self, function, file):
        self._py_file, self._line = file, function.__code__.co_firstlineno
        beside = os.path.join(os.path.dirname(file), "__pycache__")
        self._folder = os.path.join(config.CACHE_DIR, self.get_suitable_cache_subpath(file)) if config.CACHE_DIR else beside

    @classmethod
    def from_function(cls, function, file):
        return cls(function, file)

    def get_cache_path(self):
        return self._folder

    def get_source_stamp(self):
        return b""

    def get_disambiguator(self):
        return str(self._line)


class _Location(CompileResultCacheImpl):
    """Where a function is kept: in the first folder that can be written, if there is one."""

    _locator_classes = (*CompileResultCacheImpl._locator_classes, _Unwritable)

    def rebuild(self, target_context, payload):
        """A compiled function from what was kept; arguments as Numba names them."""
        (_, kind, _), *_ = payload
        return loaded(target_context, payload) if kind == LINKED else super().rebuild(target_context, payload)


class _CheckedFile(IndexDataCacheFile):
    """Compiled code with what it was compiled for, and with a sum of its bytes."""

    def save(self, key, data):
        code = dumps(data)
        super().save(key, (key, self._source_stamp, hashlib.sha256(code).digest(), code))

    def load(self, key):
        found = super().load(key)
        if found is None:
            return None
        *made_for, check, code = found
        if made_for != [key, self._source_stamp]:  # of another process, or one that was killed before it wrote the code
            return None
        if hashlib.sha256(code).digest() != check:
            raise ValueError("bytes of compiled code have changed")
        return pickle.loads(code)


class KeptCode(FunctionCache):
    """The compiled code of a function on the disk."""

    _impl_class = _Location

    def __init__(self, function):
        super().__init__(function)
        stamp = source_stamp(function.__module__) or self._impl.locator.get_source_stamp()
        self._cache_file = _CheckedFile(self.cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig, target_context):
        """The compiled function of a signature, or None; arguments as Numba names them."""
        try:
            return super().load_overload(sig, target_context)
        except OSError:  # a folder or a file that may not be read: whether it can be written, `save_overload` tells
            return None
        except Exception as error:  # a file that holds anything raises anything
            _tell_once("Compiled code in {} cannot be read ({}) and is compiled anew.", self.cache_path, error)
        with suppress(OSError):  # nor can it be written, then
            self.flush()
        return None

    def save_overload(self, sig, data):
        """Keep the compiled function of a signature, if that can be done."""
        try:
            super().save_overload(sig, data._replace(type_annotation=""))  # a listing with types, which takes long to write
        except Exception as error:  # no permission, no room, an index that can be neither read nor replaced
            _tell_once(
                "Compiled code cannot be kept in {} ({}), so that every process compiles it; set the environment variable "
                "NUMBA_CACHE_DIR to a folder that can be written.",
                self.cache_path,
                error,
            )


_told: set[str] = set()


def _tell_once(sentence, folder, error):
    """Log a sentence that has a folder and an error in it, if this process has not logged it yet."""
    if sentence not in _told:
        _told.add(sentence)
        short = folder if len(folder) < 100 else f"...{folder[-100:]}"
        LOG.warning(sentence.format(short, getattr(error, "strerror", None) or type(error).__name__))
