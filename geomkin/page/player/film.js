// The motion as a film, by the browser's own recorder: MP4 where it writes that, otherwise WebM.
import { drawingImage } from "./pictures.js";
import { max, min, round } from "./shapes.js";

// Pictures in a second, the longest film, s, and the widest one, px.
const RATE = 25, LONGEST = 12, WIDEST = 1280;
const FILMS = ["video/mp4;codecs=avc1.42E01F", "video/mp4", "video/webm;codecs=vp9", "video/webm"];
// undefined if the browser records nothing.
export const filmType = globalThis.MediaRecorder && FILMS.find((type) => MediaRecorder.isTypeSupported(type));

// Records a pass of so many seconds. show(share) shows the motion at a share of it; report(share) returns false to give up.
export async function film(drawing, seconds, show, report) {
  const count = max(2, round(min(seconds, LONGEST) * RATE)), sharp = min(2, WIDEST / drawing.wide), pictures = [], parts = [];
  for (let k = 0; k < count; k++) {
    if (!report(k / count)) return null;
    show(k / count);
    pictures.push(await drawingImage(drawing, sharp, "image/webp"));
  }
  const canvas = document.createElement("canvas"), paper = canvas.getContext("2d"), { width, height } = await createImageBitmap(pictures[0]);
  // Films have even numbers of pixels.
  [canvas.width, canvas.height] = [2 * round(width / 2), 2 * round(height / 2)];
  const recorder = new MediaRecorder(canvas.captureStream(RATE), { mimeType: filmType, videoBitsPerSecond: 6e6 });
  recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
  const ended = new Promise((resolve) => { recorder.addEventListener("stop", resolve); });
  recorder.start();
  // Each picture stays its time, also on a busy machine, which would leave out those that follow at once.
  for (const picture of pictures) {
    paper.drawImage(await createImageBitmap(picture), 0, 0);
    await new Promise((resolve) => { setTimeout(resolve, 1000 / RATE); });
  }
  recorder.stop();
  await ended;
  return new Blob(parts, { type: filmType.split(";")[0] });
}
