/** YASGUI, the editor of SPARQL, with our prefixes and our endpoint alone. */

import Yasgui from "@zazuko/yasgui";
import "@zazuko/yasgui/build/yasgui.min.css";

const KINDS = ["action", "affordance", "graph", "node", "object", "part", "rule", "speaker", "utterance"];
const BASE = "https://w3id.org/hilt";
const PREFIXES = [
  `PREFIX hilt: <${BASE}#>`,
  "PREFIX prov: <http://www.w3.org/ns/prov#>",
  ...KINDS.map((kind) => `PREFIX ${kind}: <${BASE}/${kind}/>`),
].join("\n");
const QUERY = `${PREFIXES}

SELECT ?object ?part ?lower ?upper WHERE {
  ?rule hilt:functor hilt:graspObject ; hilt:feature ?object ; hilt:part ?part ;
        hilt:lower ?lower ; hilt:upper ?upper ; hilt:status hilt:active .
} LIMIT 100`;

/** Open it in a container; what is returned closes it. */
export function openYasgui(container: HTMLElement): () => void {
  const yasgui = new Yasgui(container, {
    requestConfig: { endpoint: new URL("sparql", document.baseURI).href, method: "POST" },
    copyEndpointOnNewTab: true,
    persistenceId: null,
    populateFromUrl: false,
    yasqe: { value: QUERY, autocompleters: ["variables"], consumeShareLink: null },
  });
  return () => yasgui.destroy();
}
