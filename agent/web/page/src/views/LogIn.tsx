import { useSignal } from "@preact/signals";
import { logIn } from "../api/client";
import { attempt, notice } from "../state/notices";
import { connect } from "../state/session";

/** Asks for the key that the service has printed, or for a token. */
export function LogIn() {
  const key = useSignal("");
  const send = async (event: Event) => {
    event.preventDefault();
    notice.value = undefined;
    await attempt(() => logIn(key.value.trim()));
    if (notice.value === undefined) await connect();
  };
  return (
    <form class="pane log-in" onSubmit={(event) => void send(event)}>
      <h2>Who are you?</h2>
      <label for="key">The one-time key that “hilt serve” printed, or your token</label>
      <input
        id="key"
        type="password"
        autocomplete="off"
        value={key.value}
        onInput={(event) => (key.value = event.currentTarget.value)}
      />
      <button type="submit" class="primary" disabled={!key.value.trim()}>Enter</button>
    </form>
  );
}
