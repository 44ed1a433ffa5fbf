"""Functions that only compiled functions call: linked into each of their callers, and no machine code of their own.

Numba optimises every function with all that it calls, and makes machine code of it, even where nobody can call that code: Python
needs a wrapper, and a call by address needs another. What is linked into a caller is optimised there once more. So of a function
without wrappers it is enough to keep its code for linking, with what it calls copied in.
"""

from typing import Any

import llvmlite.binding as llvm
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, CompileResult

LINKED = "linked"


class LinkedCode(JITCodeLibrary):
    """A library of Numba's that callers link, and the processor never runs by itself."""

    @property
    def codegen(self) -> "_WithoutEnvironments":
        return _WithoutEnvironments(self._codegen)

    def _optimize_final_module(self) -> None:
        """Copy in what is to be copied in, as Numba does before it optimises; callers optimise."""
        made = self._codegen._module_pass_manager(loop_vectorize=False, slp_vectorize=False, opt=0, cost="cheap")
        passes, *builder = made if isinstance(made, tuple) else (made,)  # the latter is Numba 0.61's
        passes.run(self._final_module, *builder)

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """0, as of every function that is not there."""
        self._ensure_finalized()
        return 0

    def serialize_using_object_code(self) -> tuple[str, str, bytes]:
        """What is kept on the disk; named by Numba."""
        return self.name, LINKED, self._get_module_for_linking().as_bitcode()

    @classmethod
    def from_disk(cls, codegen: Any, name: str, code: bytes) -> "LinkedCode":
        """A library whose `serialize_using_object_code` gave `code`."""
        library = cls(codegen, name)
        library._final_module = library._shared_module = llvm.parse_bitcode(code)
        library._finalize_final_module()
        return library


class _WithoutEnvironments:
    """Numba's code generator for a library without machine code, which has no place for a pointer to objects of Python.

    What needs one, such as `print`, raises "missing Environment" when it runs. To raise an error needs none.
    """

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing; named by Numba."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)


class LinkedCompiler(Compiler):
    """Numba's compiler, which puts what it compiles into a `LinkedCode`."""

    def compile_extra(self, func: Any) -> Any:
        self.state.library = LinkedCode(self.state.targetctx.codegen(), func.__qualname__)
        return super().compile_extra(func)


def loaded(target_context: Any, payload: tuple) -> CompileResult:
    """The result of a compilation from what Numba's `CompileResult._reduce` made of it, and `LinkedCode` of its library."""
    (name, _, code), description, environment, signature, objectmode, lifted, annotation, reload_init, environments = payload
    library = LinkedCode.from_disk(target_context.codegen(), name, code)
    return CompileResult(
        typing_context=target_context.typing_context,
        target_context=target_context,
        entry_point=target_context.get_executable(library, description, environment),
        typing_error=None,
        type_annotation=annotation,
        signature=signature,
        objectmode=objectmode,
        lifted=lifted,
        fndesc=description,
        library=library,
        call_helper=None,
        environment=environment,
        metadata=None,
        reload_init=reload_init,
        referenced_envs=environments,
    )
