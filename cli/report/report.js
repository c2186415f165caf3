// Line charts: each element of class "lines" holds its data as JSON, and the legend before it shows the values under the
// pointer. Drawn anew when the colour scheme changes, and resized with the page.
(() => {
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const sizeOf = (element) => ({ width: element.clientWidth, height: element.clientHeight });
  const digits = (v) => (v == null ? "" : v >= 100 ? v.toFixed(0) : v >= 1 ? v.toFixed(2) : v.toFixed(3));

  const draw = (element, data) => {
    element.querySelector(".uplot")?.remove();
    const values = element.previousElementSibling.querySelectorAll("output");
    const axis = (label) => ({
      stroke: css("--faint"), grid: { stroke: css("--rule"), width: 1 }, ticks: { stroke: css("--rule"), width: 1 },
      label, labelSize: 18, labelFont: "12px system-ui", font: "12px system-ui",
    });
    const showValues = (u) => {
      const i = u.cursor.idx;
      values[0].textContent = i == null ? "" : data.x_names?.[i] ?? data.x[i];
      data.series.forEach((s, k) => { values[k + 1].textContent = i == null ? "" : digits(s.values[i]); });
    };
    return new uPlot({
      ...sizeOf(element),
      legend: { show: false },
      hooks: { setCursor: [showValues] },
      scales: { x: { time: false }, y: { range: (u, low, high) => [0, (high || 1) * 1.05] } },
      axes: [{ ...axis(data.x_label), size: 32, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000] },
             { ...axis(data.y_label), size: 50 }],
      series: [{}, ...data.series.map((s) => ({
        label: s.name, stroke: css(`--line-${s.color}`), width: 2, dash: s.dashed ? [6, 4] : undefined,
        points: { show: data.x.length < 2 || undefined },
      }))],
    }, [data.x, ...data.series.map((s) => s.values)], element);
  };

  const charts = [...document.querySelectorAll(".lines")].map((element) => {
    const data = JSON.parse(element.querySelector("script").textContent);
    return { element, data, plot: draw(element, data) };
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    for (const chart of charts) chart.plot = draw(chart.element, chart.data);
  });
  addEventListener("resize", () => {
    for (const { element, plot } of charts) plot.setSize(sizeOf(element));
  });
})();
