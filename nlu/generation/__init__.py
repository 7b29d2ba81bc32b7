"""Generation of text: meanings as sentences that parse back to them, and spoken answers.

realizer   surface realisation of meanings, with the sentences of `sentences.yaml`
templates  answers of `answers.yaml`, with slots that ask for a form: `{object:a}`
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
