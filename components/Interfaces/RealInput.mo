within Interfaces;
connector RealInput = input Real "Real signal, input";
