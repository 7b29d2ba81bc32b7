/** Experiments: begun, watched, and read as reports. */
export function Evaluations() {
  return <section class="pane evaluations"><h2>Evaluations</h2></section>;
}
