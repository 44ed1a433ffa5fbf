// Tension and energy over time, with a line at the time that is shown.

function makeStrips(content, canvas) {
  const times = unpack(content.curves.t), first = times[0], last = times[times.length - 1], pen = canvas.getContext("2d");
  const panels = [
    { title: "largest tension [N]", curves: [{ name: "", colour: "#920fa3", values: unpack(content.curves.tension) }] },
    { title: "energy [J]", curves: content.curves.energies.map((one) => ({ ...one, values: unpack(one.values) })) },
  ];
  for (const panel of panels) {
    const all = panel.curves.flatMap(({ values }) => [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))]);
    panel.low = Math.min(0, ...all);
    panel.high = Math.max(0, ...all);
    if (panel.high === panel.low) panel.high = panel.low + 1;
  }
  const left = 70, right = 12;

  function x(t) {
    return left + ((t - first) / (last - first || 1)) * (canvas.clientWidth - left - right);
  }

  // Time at a position on the canvas, from its left [px].
  function timeAt(px) {
    const share = (px - left) / (canvas.clientWidth - left - right);
    return first + Math.min(1, Math.max(0, share)) * (last - first);
  }

  function drawPanel(panel, top, height) {
    const y = (value) => top + height - ((value - panel.low) / (panel.high - panel.low)) * height;
    pen.strokeStyle = "#d5dbdf";
    pen.fillStyle = "#5c676e";
    pen.lineWidth = 1;
    pen.textBaseline = "middle";
    pen.textAlign = "right";
    for (const value of new Set([panel.low, 0, panel.high])) {
      pen.beginPath();
      pen.moveTo(left, y(value));
      pen.lineTo(canvas.clientWidth - right, y(value));
      pen.stroke();
      if (value === 0 || Math.abs(y(value) - y(0)) > 11) pen.fillText(short(value), left - 6, y(value));
    }
    pen.strokeStyle = "#b9882f";
    pen.setLineDash([3, 3]);
    for (const event of content.events) {
      pen.beginPath();
      pen.moveTo(x(event.t), top);
      pen.lineTo(x(event.t), top + height);
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.lineWidth = 1.6;
    for (const curve of panel.curves) {
      pen.strokeStyle = curve.colour;
      pen.beginPath();
      curve.values.forEach((value, i) => pen.lineTo(x(times[i]), y(value)));
      pen.stroke();
    }
    pen.textAlign = "left";
    pen.textBaseline = "alphabetic";
    pen.fillStyle = "#1d2428";
    pen.font = "600 12px Arial, sans-serif";
    pen.fillText(panel.title, left, top - 6);
    let at = left + pen.measureText(panel.title).width + 18;
    pen.font = "12px Arial, sans-serif";
    for (const curve of panel.curves.filter((one) => one.name)) {
      const name = curve.name === "potential" ? "potential (since the start)" : curve.name;
      pen.fillStyle = curve.colour;
      pen.fillRect(at, top - 11, 14, 3);
      pen.fillText(name, at + 18, top - 6);
      at += 34 + pen.measureText(name).width;
    }
  }

  function draw(t) {
    const ratio = window.devicePixelRatio || 1, [width, height] = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = ratio * width;
    canvas.height = ratio * height;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = "12px Arial, sans-serif";
    const tall = (height - 68) / 2;
    drawPanel(panels[0], 20, tall);
    drawPanel(panels[1], 48 + tall, tall);
    pen.fillStyle = "#5c676e";
    pen.textBaseline = "alphabetic";
    for (const [share, way] of [[0, "left"], [0.25, "center"], [0.5, "center"], [0.75, "center"], [1, "right"]]) {
      const at = first + share * (last - first);
      pen.textAlign = way;
      pen.fillText(`${short(at)} s`, x(at), height - 4);
    }
    pen.strokeStyle = "#1d2428";
    pen.lineWidth = 1.2;
    pen.beginPath();
    pen.moveTo(x(t), 20);
    pen.lineTo(x(t), height - 18);
    pen.stroke();
  }

  return { draw, timeAt };
}
