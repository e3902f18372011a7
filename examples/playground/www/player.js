// A button, a slider of time and a clock, which show a moment of something that moves.

export class Player {
  /** `show(time)` draws a moment; `words(time)` says it. */
  constructor({ button, slider, clock, show, words = time => `${time.toFixed(2)} s`, rate = () => 1 }) {
    Object.assign(this, { button, slider, clock, show, words, rate, time: 0, length: 0, playing: false, frame: 0 });
    button.addEventListener("click", () => {
      if (!this.playing && this.time >= this.length - 1e-6) this.at(0);
      this.play(!this.playing);
    });
    slider.addEventListener("input", () => { this.stop(); this.at(Number(slider.value)); });
  }

  /** Something else is shown, of some length; the time stays as far as it can. */
  begin(length) {
    this.length = length;
    this.slider.max = length;
    for (const control of [this.slider, this.button]) control.disabled = !length;
    this.at(Math.min(this.time, length));
  }

  at(time) {
    this.time = time;
    this.show(time);
    this.slider.value = time;
    this.slider.setAttribute("aria-valuetext", this.words(time));
    this.clock.textContent = this.words(time);
  }

  play(on) {
    this.playing = on;
    this.button.textContent = on ? "❚❚" : "▶";
    this.button.setAttribute("aria-label", on ? "Pause" : "Play");
    cancelAnimationFrame(this.frame);
    if (!on) return;
    let last = performance.now();
    const tick = now => {
      const next = this.time + Math.max(0, now - last) / 1000 * this.rate();
      last = now;
      if (next >= this.length) {
        this.at(this.length);
        return this.play(false);
      }
      this.at(next);
      this.frame = requestAnimationFrame(tick);
    };
    this.frame = requestAnimationFrame(tick);
  }

  stop() { if (this.playing) this.play(false); }
}
