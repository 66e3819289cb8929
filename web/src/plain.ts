// Pictures that the server draws, where the browser draws nothing in three dimensions.

import { byId } from "./dom";

/** What a picture shows: the part with its stress, or the program. */
type Of = "part" | "program";

/** The figure in place of the view. It holds a picture of the part and one of the program, and shows one of them. */
export class Plain {
  private readonly figure = byId("plain");
  private readonly pictures = new Map<Of, { address: string; words: string }>();
  private shown: Of = "part";

  /** `hasView` tells whether the browser draws the view itself; then there is no picture. */
  constructor(private readonly hasView: () => boolean) {}

  /** Takes the picture of this address, with what it shows in words. */
  take(of: Of, address: string, words: string): void {
    this.pictures.set(of, { address, words });
    this.show(this.shown);
  }

  /** Forgets what belongs to the file that was open. */
  clear(): void { this.pictures.clear(); this.show(this.shown); }

  /** Shows the picture of the part or that of the program, where there is one. */
  show(of: Of): void {
    this.shown = of;
    const picture = this.hasView() ? undefined : this.pictures.get(of) ?? [...this.pictures.values()][0];
    this.figure.hidden = !picture;
    if (!picture) return;
    const [image, caption] = [this.figure.querySelector("img")!, this.figure.querySelector("figcaption")!];
    // A picture that is set anew is asked for anew.
    if (image.getAttribute("src") !== picture.address) image.src = picture.address;
    image.alt = picture.words;
    caption.textContent = picture.words;
  }
}
