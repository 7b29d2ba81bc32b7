/** Short notices to the person, above all the refusals of the service. */

import { signal } from "@preact/signals";
import { Refusal } from "../api/client";

export const notice = signal<string | undefined>(undefined);

/** Do something, and show a refusal as a notice; any other error is a fault of the page. */
export async function attempt<T>(work: () => Promise<T>): Promise<T | undefined> {
  try {
    return await work();
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    notice.value = error.message;
    return undefined;
  }
}
