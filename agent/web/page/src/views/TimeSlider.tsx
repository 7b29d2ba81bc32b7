import { lastSequence, utterances } from "../state/conversation";
import { goTo, moment } from "../state/rules";

/** The base at an earlier utterance: dragging it shows the rules as they were. */
export function TimeSlider() {
  const last = lastSequence.value;
  const at = moment.value ?? last;
  const said = utterances.value.find((each) => each.sequence === at);
  if (last < 2) return null;
  return (
    <div class={`slider ${moment.value === undefined ? "" : "past"}`}>
      <label for="moment">
        {moment.value === undefined ? "Now" : <strong>As of utterance {at}</strong>}
      </label>
      <input
        id="moment"
        type="range"
        min={1}
        max={last}
        value={at}
        aria-valuetext={`utterance ${at}: ${said?.text ?? ""}`}
        onInput={(event) => goTo(event.currentTarget.valueAsNumber)}
      />
      {moment.value !== undefined && (
        <>
          <q>{said?.text}</q>
          <button type="button" onClick={() => goTo(last)}>Back to now</button>
        </>
      )}
    </div>
  );
}
