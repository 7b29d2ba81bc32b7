/** The routes of the service, to read and to try, from its own OpenAPI document. */

import SwaggerUI from "swagger-ui-dist/swagger-ui-es-bundle.js";
import "swagger-ui-dist/swagger-ui.css";

SwaggerUI({ url: "openapi.json", dom_id: "#docs", validatorUrl: null });
