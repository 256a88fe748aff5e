within Interfaces;
connector RealOutput = output Real "Real signal, output";
