"""Which exceptions a compiled function may raise: there is nobody to catch them where it is called by its address."""

import pickle
import re

from integrators.compile_once import compiling, once


@once
def may_raise(kernel):
    """What a compiled function may raise, but for a lack of memory, of which no law can be asked to beware.

    Read from its optimised code, in which no exception is left that cannot be reached: Numba keeps each one there as a pickled
    constant, beside its hash.

    Parameters
    ----------
    kernel : compiled by Numba for one signature

    Returns
    -------
    tuple of str : such as "ValueError in line 6"
    """
    (compiled,) = kernel.overloads.values()
    with compiling():
        constants = [(one.name, str(one)) for one in compiled.library._get_module_for_linking().global_variables]
    found = [_described(text) for name, text in constants if name.startswith(".const.pickledata") and not name.endswith(".sha1")]
    return tuple(dict.fromkeys(words for words in found if words))


def _described(constant):
    """The class of an exception and the line that raises it, from LLVM's text of a pickled constant.

    "" for a lack of memory, and for a constant that is none: an exception is its class, its arguments and where it is raised.
    """
    text = re.search(r' c"(.*)"', constant)[1].encode()
    data = re.sub(rb"\\(\\|[0-9A-Fa-f]{2})", lambda byte: b"\\" if byte[1] == b"\\" else bytes([int(byte[1], 16)]), text)
    try:
        found = pickle.loads(data)
    except Exception:  # a class that is not to be had here
        return "an exception"
    if not (isinstance(found, tuple) and isinstance(found[0], type)) or found[0] is MemoryError:
        return ""
    return found[0].__name__ + (f" in line {found[2][2]}" if len(found) > 2 and found[2] else "")
