// Play, pause, scrub and speed, and what joins the scene to the curves.

(function () {
  const content = JSON.parse(document.getElementById("content").textContent), $ = (id) => document.getElementById(id);
  const strips = makeStrips(content, $("strips")), still = { times: unpack(content.states.t), options: {} };
  for (const name of ["show", "draw", "fit", "follow", "resize"]) still[name] = () => {};
  let stage = still;
  try {
    stage = makeStage(content, $("stage"));
  } catch (error) {
    console.warn(error);
    $("nothing").hidden = false;
    $("legend").hidden = true;
  }
  const times = stage.times, first = times[0], last = times[times.length - 1], span = last - first;

  const speeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 1000];
  const calm = speeds.findLast((speed) => span / speed >= 3) ?? speeds[0], hurried = speeds.find((speed) => span / speed <= 60) ?? 1000;
  const usual = span < 3 ? calm : hurried > 1 ? hurried : 1; // neither over in a moment nor after minutes
  for (const speed of speeds) $("speed").add(new Option(`${speed}×`, speed, speed === usual, speed === usual));

  let t = first, playing = false, before = 0;

  function show(time) {
    t = Math.min(last, Math.max(first, time));
    $("time").textContent = `t = ${t.toFixed(span < 1 ? 4 : span < 100 ? 2 : 1)} s`;
    $("scrub").value = span > 0 ? (10000 * (t - first)) / span : 0;
    stage.show(t);
    strips.draw(t);
  }

  function play(on) {
    playing = on;
    $("play").textContent = on ? "Pause" : "Play";
    if (on) {
      if (t >= last) show(first);
      before = performance.now();
      requestAnimationFrame(tick);
    }
  }

  function tick(now) {
    if (!playing) return;
    show(t + (Number($("speed").value) * Math.max(0, now - before)) / 1000);
    before = now;
    if (t >= last) play(false); else requestAnimationFrame(tick);
  }

  // The saved state before or after the time that is shown.
  function step(by) {
    play(false);
    const [i, f] = place(times, t);
    show(times[Math.min(times.length - 1, Math.max(0, (by > 0 ? i + 1 : f > 0 ? i : i - 1) + (by > 0 && f >= 1 ? 1 : 0)))]);
  }

  $("play").onclick = () => play(!playing);
  $("scrub").oninput = () => { play(false); show(first + (span * $("scrub").value) / 10000); };
  $("fit").onclick = () => { stage.fit(); stage.draw(); };
  $("names").onchange = () => { stage.options.names = $("names").checked; stage.draw(); };
  $("traces").onchange = () => { stage.options.traces = $("traces").checked; stage.draw(); };
  $("follow").onchange = () => { stage.follow($("follow").checked); stage.draw(); };
  const drag = (event) => { if (event.buttons) { play(false); show(strips.timeAt(event.offsetX)); } };
  $("strips").onpointerdown = (event) => { $("strips").setPointerCapture(event.pointerId); drag(event); };
  $("strips").onpointermove = drag;
  addEventListener("keydown", (event) => {
    if (event.target.tagName === "SELECT" || event.target.tagName === "INPUT") return;
    if (event.key === " ") { event.preventDefault(); play(!playing); }
    if (event.key === "ArrowRight") step(1);
    if (event.key === "ArrowLeft") step(-1);
  });
  new ResizeObserver(() => { stage.resize(); stage.draw(); strips.draw(t); }).observe($("stage"));

  $("bar").style.background = `linear-gradient(to top, ${content.colours.tension.join(", ")})`;
  $("half").textContent = short(content.full_scale / 2);
  $("full").textContent = short(content.full_scale);
  $("names").checked = stage.options.names = content.points.length <= 30;
  $("follow").checked = content.follow;
  stage.resize();
  show(first);
  stage.fit();
  show(first);
})();
