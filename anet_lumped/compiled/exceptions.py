"""Which exceptions a compiled function may raise. An exception of a function that is called by its address would be lost."""

import pickle
import re

from integrators.compile_once import compiling, once


@once
def may_raise(kernel):
    """Exceptions that a compiled function may raise, except for a lack of memory, which no law can avoid.

    Numba keeps each exception as a pickled constant, beside its hash, in the optimised code. Exceptions that cannot be reached are
    not in that code any more.

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

    "" for a lack of memory, and for a constant that is no exception. Numba writes an exception as its class, its arguments, and the
    place where it is raised.
    """
    text = re.search(r' c"(.*)"', constant)[1].encode()
    data = re.sub(rb"\\(\\|[0-9A-Fa-f]{2})", lambda byte: b"\\" if byte[1] == b"\\" else bytes([int(byte[1], 16)]), text)
    try:
        found = pickle.loads(data)
    except Exception:  # a class that cannot be imported here
        return "an exception"
    if not (isinstance(found, tuple) and isinstance(found[0], type)) or found[0] is MemoryError:
        return ""
    return found[0].__name__ + (f" in line {found[2][2]}" if len(found) > 2 and found[2] else "")
