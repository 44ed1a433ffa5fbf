"""Equations as MathML, which browsers show by themselves: no script, no font and no network is needed to read the pages."""

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

logger = logging.getLogger(__name__)


def _mathml(text, node, block):
    try:
        return tex2mathml(text, as_block=block)
    except MathError as error:
        logger.warning("This equation is not understood: %s\n%s", error, text, location=node)
        return text


def visit_inline(translator, node):
    """Write an equation within a sentence."""
    translator.body.append(_mathml(node.astext(), node, block=False))
    raise nodes.SkipNode


def visit_block(translator, node):
    """Write an equation of its own."""
    translator.body.append(
        f'<div class="equation">{_mathml(node.astext(), node, block=True)}</div>'
    )
    raise nodes.SkipNode


def setup(app):
    """Offer the renderer to Sphinx."""
    app.add_html_math_renderer(
        "mathml", inline_renderers=(visit_inline, None), block_renderers=(visit_block, None)
    )
    return {"parallel_read_safe": True, "parallel_write_safe": True}
