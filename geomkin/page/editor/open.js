// Leads a link to the studio that this browser opened last: only the browser knows the token in its address.
let place = null;
try { place = localStorage.getItem("geomkin-studio"); } catch { /* A browser may keep nothing. */ }
const reply = place ? await fetch(`${place}start`).catch(() => null) : null;
if (reply?.ok) location.replace(`${place}${location.hash}`);
else document.getElementById("said").textContent = "Open the studio in this browser first, by `geomkin studio` in a terminal, and then this link again.";
