"""Files: what a base is exported to and imported from.

registry        the formats, by name and extension, and what each of them carries
import_export   export and import of a file or a text
file_streams    files, compressed or not, and the limits on what is read
value_notation  atoms, intervals and times as a person types them
csv_table       rules as a CSV table
rule_yaml       rules as a YAML sheet
graphml         rules as a networkx graph and as GraphML
drawing         the rule graph as SVG or PNG
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
