import { render } from "preact";
import { connect } from "./state/session";
import "./styles/base.css";
import "./styles/views.css";
import { App } from "./views/App";

const page = document.getElementById("page");
if (page) {
  page.replaceChildren();
  render(<App />, page);
  void connect();
}
