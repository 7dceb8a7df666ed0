// Requests to the studio's server. Addresses are relative to that of the page, which contains the token.

// The error of a request that the server refuses, with the problems that it states.
export class Refused extends Error {
  constructor(status, problems) {
    super(problems.map(({ problem, remedy }) => [problem, remedy].filter(Boolean).join("; ")).join(". "));
    Object.assign(this, { status, problems });
  }
}

const GONE = [{ key: "", problem: "the studio does not answer", remedy: "start it again; your changes are still here", id: "gone" }];

async function request(path, options) {
  let response;
  try { response = await fetch(path, options); } catch { throw new Refused(0, GONE); }
  const reply = await response.json().catch(() => ({}));
  if (!response.ok) throw new Refused(response.status, reply.problems ?? GONE);
  return reply;
}

export const get = (path, query = {}) => request(`${path}?${new URLSearchParams(query)}`);

export const post = (path, body = {}) =>
  request(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });

// Waits for the end of a job and returns its state; `progress(job)` is called with every state on the way.
export async function finished(id, progress) {
  for (let wait = 60; ; wait = Math.min(400, 1.5 * wait)) {
    const job = await get("job", { id });
    progress(job);
    if (job.state !== "running") return job;
    await new Promise((resolve) => { setTimeout(resolve, wait); });
  }
}
