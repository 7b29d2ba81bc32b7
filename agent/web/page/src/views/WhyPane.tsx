import { Tabs, type Tab } from "../parts/Tabs";
import { graph } from "../state/rules";
import { isBusy } from "../state/execution";
import { utterances } from "../state/conversation";
import { tab, type WhyTab } from "../state/view";
import { ActionTree } from "./ActionTree";
import { HistoryView } from "./HistoryView";
import { ProofView } from "./ProofView";
import { RulesView } from "./RulesView";

const VIEWS = { tree: ActionTree, proof: ProofView, rules: RulesView, history: HistoryView };

export function WhyPane() {
  const View = VIEWS[tab.value];
  const tabs: readonly (Tab & { name: WhyTab })[] = [
    { name: "tree", label: "Action", mark: isBusy.value ? "●" : undefined },
    { name: "proof", label: "Proof" },
    { name: "rules", label: "Rules", mark: String(graph.value.edges.length) },
    { name: "history", label: "History", mark: String(utterances.value.length) },
  ];
  return (
    <section class="pane why" aria-labelledby="why-title">
      <h2 id="why-title">Why</h2>
      <Tabs label="Reasons" tabs={tabs} chosen={tab.value} choose={(name) => (tab.value = name as WhyTab)}>
        <View />
      </Tabs>
    </section>
  );
}
