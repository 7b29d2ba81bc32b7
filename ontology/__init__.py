# SPDX-License-Identifier: Apache-2.0
"""What the words mean: the data that every other package reads, and the errors they raise.

vocabulary  the classes and properties of the graph, and how a name becomes an IRI
object      a kind of thing, with its parts and properties
part        what an object is held or used by: a handle, a blade
action      something the robot can do; an action tree says how
qualifier   a word of confidence and its interval: "often" is [0.75, 1]

>>> from hilt.ontology.objects import load_objects
>>> sorted(load_objects()["knife"].parts)
['blade', 'handle']
"""
