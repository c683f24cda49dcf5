"""The schemas of FMI-LS-REF and MA-HS-Experiments, which refer to those of FMI by address."""

from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from lxml import etree

_HERE = Path(__file__).parents[1] / "schemas"
_OF_FMI = Path(fmpy.__file__).parent / "schema" / "fmi3"
_XS = "http://www.w3.org/2001/XMLSchema"
MANIFEST = "fmi3LayeredStandardReferenceManifest.xsd"
EXPERIMENTS = "maHarmonizedSpecificationExperiments.xsd"


class _FromFmpy(etree.Resolver):
    """Finds the schemas of FMI in fmpy instead of in the network."""

    def resolve(self, url: str, _public: Any, context: Any) -> Any:
        """Return the schema of an address, None for anything else."""
        file = _OF_FMI / url.rpartition("/")[2]
        return self.resolve_filename(str(file), context) if file.is_file() else None


@cache
def schema(name: str) -> etree.XMLSchema:
    """Return a schema.

    Parameters
    ----------
    name : str
        :data:`MANIFEST` or :data:`EXPERIMENTS`.
    """
    parser = etree.XMLParser(no_network=True)
    parser.resolvers.add(_FromFmpy())
    document = etree.parse(_HERE / name, parser)
    # a schema without a namespace cannot import another one: the draft of 2026 means to include it
    for imported in document.getroot().findall(f"{{{_XS}}}import"):
        if imported.get("namespace") is None:
            imported.tag = f"{{{_XS}}}include"
    return etree.XMLSchema(document)
