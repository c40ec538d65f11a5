// What the atlas and the view of rods share: numbers as the page's tables have them, and parts of drawings.
const pageNumbers = (() => {
  const superscript = (n) => String(n).replace(/./g, (c) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(c)]);
  const number = (value, digits = 4) => {
    const [mantissa, power] = value.toPrecision(digits).split("e");
    return mantissa.replace("-", "−") + (power ? ` × 10${superscript(Number(power))}` : "");
  };
  const percent = (value, digits = 4) =>
    (value === null ? "no such mode" : (value > 0 ? "+" : "") + number(100 * value, digits));
  const node = (parent, name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    parent.appendChild(made);
    return made;
  };
  return { superscript, number, percent, node };
})();
